package waymark.spy;

import java.awt.event.ActionEvent;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import waymark.image_t;

/**
 * Opens a window that shows the images of a channel. lcm-spy finds this class
 * by itself; it must implement the interface directly and be constructible
 * without arguments.
 */
public final class ImagePlugin implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == image_t.LCM_FINGERPRINT;
  }

  /** Also called with nulls, for the action's name alone. */
  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction("Image viewer") {
      private static final long serialVersionUID = 1;

      @Override
      public void actionPerformed(ActionEvent event) {
        if (desktop != null && channel != null) {
          ImageViewer.open(desktop, channel.name);
        }
      }
    };
  }
}
